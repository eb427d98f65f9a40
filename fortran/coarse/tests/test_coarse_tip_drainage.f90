!> The rock around tips, drained by the fluid on the faces: exact along one cell behind the tip
!! wherever the tip lies in its cell, without a change beyond the length of a cell, and continuous
!! as the tip moves through the cells.
program test_coarse_tip_drainage
   use base_kinds, only: ik, rk
   use coarse_tip_drainage, only: drained_tip_t, drained_tips, pressure_at, pressure_of_face
   use mesh_types, only: mesh_t
   use sample_bodies, only: mesh_square, straight_network
   use testing_checks, only: checks_t
   implicit none(type, external)

   real(rk), parameter :: beyond = 4.0e6_rk, slope = 2.0e6_rk  ! [Pa], [Pa/m]
   type(checks_t) :: checks
   type(mesh_t) :: mesh
   integer :: i

   call mesh_square(checks, straight_network(reshape([0.3_rk, 1.0_rk, 1.7_rk, 1.0_rk], &
                                                     [2, 2, 1])), &
                    0.2_rk, 0.4_rk, mesh)
   call test_no_change()
   call test_faces()
   call test_continuity()
   do i = 1, 12
      call mesh_square(checks, straight_network(reshape([0.11_rk, 0.13_rk, 1.61_rk, &
                                                         0.6_rk + 0.07_rk*i], [2, 2, 1])), &
                       0.2_rk, 0.4_rk, mesh)
      call test_end_of_cell()
   end do
   call checks%finish()

contains

   !> Pressure of the fluid, which is linear [Pa].
   pure function fluid()
      real(rk) :: fluid(mesh%fracture%n_cells)
      integer(ik) :: i

      fluid = [(beyond + slope*0.5_rk*sum(mesh%fracture%point_xy(1, mesh%fracture%cell_points(:, &
                                                                  i))), i=1, mesh%fracture%n_cells)]
   end function fluid

   !> Pressure of the rock: the fluid's less a constant, and a suction around the tips [Pa].
   pure function rock(suction)
      real(rk), intent(in) :: suction
      real(rk) :: rock(mesh%n_nodes)
      integer(ik) :: v

      rock = slope*mesh%xy(1, :)
      do v = 1, mesh%n_nodes
         associate (x => mesh%xy(1, v), y => mesh%xy(2, v))
            if (x < 0.6_rk .or. x > 1.4_rk) rock(v) = rock(v) &
                                - suction*(1.0_rk + 0.5_rk*sin(40.0_rk*x + 30.0_rk*y + real(v, rk)))
         end associate
      end do
   end function rock

   !> Shares behind the tips: one lies in its cell, the other at its end [-].
   pure function passed(first)
      real(rk), intent(in) :: first
      real(rk) :: passed(mesh%fracture%n_cells)

      passed = 1.0_rk
      passed(1) = first
   end function passed

   !> Pressure at the middles of all faces of the mesh [Pa].
   pure function at_faces(tips, nodal) result(p)
      type(drained_tip_t), intent(in) :: tips(:)
      real(rk), intent(in) :: nodal(:)
      real(rk) :: p(mesh%n_faces)
      integer(ik) :: f

      p = [(pressure_of_face(tips, mesh, nodal, f), f=1, mesh%n_faces)]
   end function at_faces

   !> Where the rock's pressure differs from the fluid's by a constant nothing changes.
   subroutine test_no_change()
      type(drained_tip_t), allocatable :: tips(:)
      real(rk) :: nodal(mesh%n_nodes), still(mesh%n_faces)

      nodal = rock(0.0_rk)
      tips = drained_tips(mesh, nodal, fluid(), passed(0.3_rk))
      still = at_faces([drained_tip_t ::], nodal)
      call checks%is_true(size(tips) == 2 .and. all(tips%reach > 0.0_rk), "two tips")
      call checks%is_close(maxval(abs(at_faces(tips, nodal) - still)), 0.0_rk, 1.0e-9_rk*beyond, &
                           "no change")
   end subroutine test_no_change

   !> On the faces behind the tip the suction is drained, on both sides; far away it is not.
   subroutine test_faces()
      real(rk), parameter :: share(4) = [1.0_rk, 0.75_rk, 0.5_rk, 0.25_rk]
      type(drained_tip_t), allocatable :: tips(:)
      real(rk) :: cell, nodal(mesh%n_nodes), p(mesh%n_faces), weights(3), worst, x
      integer(ik) :: behind, c, f, k, side

      nodal = rock(1.0e6_rk)
      cell = mesh%fracture%cell_s(2, 1) - mesh%fracture%cell_s(1, 1)
      do k = 1, size(share, kind=ik)
         tips = drained_tips(mesh, nodal, fluid(), passed(share(k)))
         worst = 0.0_rk
         do behind = 0, 4  ! in quarters of a cell behind the tip
            ! Just beyond the last of these places, as on the next cell.
            associate (from_end => 1.0_rk - share(k) + 0.25_rk*behind + merge(1.0e-10_rk, 0.0_rk, &
                                                                              behind == 4))
               c = merge(1_ik, 2_ik, from_end <= 1.0_rk)
               x = 0.3_rk + from_end*cell
               do side = 1, 2
                  f = mesh%fracture%cell_faces(side, c)
                  weights = on_face(f, x)
                  if (behind == 0) cycle  ! at the tip the sides have one pressure: their mean
                  ! The difference of the sides, which is not drained yet near the tip, vanishes
                  ! one cell behind it.
                  if (behind == 4) worst = max(worst, &
                                abs(pressure_at(tips, mesh, nodal, mesh%face_cells(1, f), weights) &
                                                   - slope*x))
               end do
               worst = max(worst, abs(mean_of_sides(tips, nodal, c, x) - slope*x))
            end associate
         end do
         call checks%is_close(worst, 0.0_rk, 1.0e-9_rk*beyond, "drained faces")
         p = at_faces(tips, nodal) - at_faces([drained_tip_t ::], nodal)
         do f = 1, mesh%n_faces
            x = minval(abs(0.5_rk*sum(mesh%xy(1, mesh%face_nodes(:, f))) - [0.3_rk, 1.7_rk]))
            if (x > (3.0_rk - share(k))*cell) worst = max(worst, abs(p(f)))
         end do
         call checks%is_close(worst, 0.0_rk, 1.0e-9_rk*beyond, "no change out of reach")
      end do
   end subroutine test_faces

   !> A tip that has just entered a cell has the pressures of a tip at the end of the one before.
   subroutine test_continuity()
      type(drained_tip_t), allocatable :: ahead(:), back(:)
      real(rk), parameter :: little = 1.0e-6_rk
      real(rk) :: nodal(mesh%n_nodes), shares(mesh%fracture%n_cells)

      nodal = rock(1.0e6_rk)
      ahead = drained_tips(mesh, nodal, fluid(), passed(little))
      shares = passed(1.0e-3_rk)
      shares(2) = 1.0_rk - little
      back = drained_tips(mesh, nodal, fluid(), shares)
      call checks%is_true(maxval(abs(at_faces(ahead, nodal) &
                                     - at_faces([drained_tip_t ::], nodal))) > 1.0e5_rk, &
                          "there is a change")
      call checks%is_close(maxval(abs(at_faces(ahead, nodal) - at_faces(back, nodal))), 0.0_rk, &
                           1.0e-4_rk*1.0e6_rk, "continuous from cell to cell")
   end subroutine test_continuity

   !> A tip at the end of its cell, of whose drained faces none are those of another cell, has the
   !! pressures of one just before the end, on both sides of an inclined fracture.
   subroutine test_end_of_cell()
      real(rk), parameter :: little = 1.0e-9_rk
      real(rk) :: nodal(mesh%n_nodes)

      nodal = rock(1.0e6_rk)
      call checks%is_close(maxval(abs(at_faces(drained_tips(mesh, nodal, fluid(), &
                                                            passed(1.0_rk)), nodal) &
                                      - at_faces(drained_tips(mesh, nodal, fluid(), &
                                                              passed(1.0_rk - little)), nodal))), &
                           0.0_rk, 10.0_rk*little*beyond, "at the end of the cell")
   end subroutine test_end_of_cell

   !> Mean of the pressures on both faces of a fracture cell [Pa].
   pure real(rk) function mean_of_sides(tips, nodal, c, x) result(p)
      type(drained_tip_t), intent(in) :: tips(:)
      real(rk), intent(in) :: nodal(:)
      integer(ik), intent(in) :: c
      real(rk), intent(in) :: x  !< [m]
      integer(ik) :: f, side

      p = 0.0_rk
      do side = 1, 2
         f = mesh%fracture%cell_faces(side, c)
         p = p + 0.5_rk*pressure_at(tips, mesh, nodal, mesh%face_cells(1, f), on_face(f, x))
      end do
   end function mean_of_sides

   !> Weights of the nodes of the cell at a face for a point on the face [-].
   pure function on_face(f, x) result(weights)
      integer(ik), intent(in) :: f
      real(rk), intent(in) :: x  !< [m]
      real(rk) :: weights(3)
      integer(ik) :: i

      associate (nodes => mesh%face_nodes(:, f), cell => mesh%cell_nodes(:, mesh%face_cells(1, f)))
         associate (ends => mesh%xy(1, nodes))
            do i = 1, 3
               weights(i) = 0.0_rk
               if (cell(i) == nodes(1)) weights(i) = (ends(2) - x)/(ends(2) - ends(1))
               if (cell(i) == nodes(2)) weights(i) = (x - ends(1))/(ends(2) - ends(1))
            end do
         end associate
      end associate
   end function on_face

end program test_coarse_tip_drainage
