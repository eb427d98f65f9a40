!> Transfer of an irregular state to a mesh on which a fracture has grown at both ends: exactly
!! preserved parts, conserved quantities, and initial values of new fracture cells.
program test_twolevel_transfer
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use coarse_layout, only: fracture_layout_t
   use coarse_state, only: fracture_cells_t, guess_t, state_t
   use contact_law, only: contact_law_t, state_open, state_slip, state_stick
   use growth_network, only: extend
   use mesh_builder, only: mesher_t, remesh
   use mesh_geometry, only: cell_area
   use mesh_types, only: mesh_map_t, mesh_t, network_t
   use sample_bodies, only: mesh_square, scattered, straight_network, uniform_cells
   use testing_checks, only: checks_t
   use twolevel_guess, only: transfer_guess
   use twolevel_transfer, only: transfer_cells, transfer_state
   implicit none(type, external)

   real(rk), parameter :: new_aperture = 1.0e-5_rk  !< [m]
   type(checks_t) :: checks
   type(mesher_t) :: mesher_before, mesher
   type(mesh_t) :: mesh_before, mesh
   type(mesh_map_t) :: map

   call grow_mesh()
   call test_cells()
   call test_state(.false.)
   call test_state(.true.)
   call test_guess()
   call test_uniform_content()
   call test_joint(0.5_rk)
   call test_joint(0.2_rk)
   call checks%finish()

contains

   !> Two fractures; the first grows by two cells at its start and one at its end, with kinks.
   subroutine grow_mesh()
      type(network_t) :: network
      type(error_t), allocatable :: error
      real(rk), parameter :: lines(2, 2, 2) = reshape([0.7_rk, 0.8_rk, 1.2_rk, 1.1_rk, 0.5_rk, &
                                                       1.5_rk, 1.5_rk, 1.6_rk], [2, 2, 2])
      real(rk), parameter :: tips(2, 2) = reshape([0.55_rk, 0.9_rk, 1.25_rk, 1.02_rk], [2, 2])

      network = straight_network(lines)
      call mesh_square(checks, network, 0.1_rk, 0.3_rk, mesh_before, mesher_before)
      call extend(network, 1_ik, 1_ik, tips(:, 1))
      call extend(network, 1_ik, 2_ik, tips(:, 2))
      call remesh(mesher_before, network, tips, 0.3_rk, 0.1_rk, mesher, mesh, map, error)
      call checks%no_error(error, "mesh after growth")
      call checks%is_true(count(map%fracture_cell_old == 0) >= 3, "new fracture cells")
      call checks%is_true(any(map%cell_old == 0) .and. any(map%cell_old > 0), "cells old and new")
   end subroutine grow_mesh

   !> Laws and residual apertures that differ from cell to cell.
   subroutine various_cells(cells)
      type(fracture_cells_t), intent(out) :: cells
      integer(ik) :: i

      cells = uniform_cells(mesh_before, contact_law_t(), 1.0e-3_rk)
      do i = 1, mesh_before%fracture%n_cells
         cells%law(i) = contact_law_t(friction=0.1_rk*i, dilation=0.01_rk*i)
         cells%residual_aperture(i) = 1.0e-4_rk*i
         cells%roughness(i) = 1.0e-6_rk*i
      end do
   end subroutine various_cells

   subroutine test_cells()
      type(fracture_cells_t) :: after, before
      integer(ik) :: first, i, last, old

      call various_cells(before)
      call transfer_cells(mesh_before, mesh, before, new_aperture, .false., after)
      associate (here => mesh%fracture%cell_fracture, there => mesh_before%fracture%cell_fracture)
         first = findloc(there, 1_ik, dim=1)
         last = findloc(there, 1_ik, dim=1, back=.true.)
         do i = 1, mesh%fracture%n_cells
            old = map%fracture_cell_old(i)
            if (old > 0) then
               call checks%is_true(here(i) == there(old), "a cell stays in its fracture")
               call checks%is_close(after%residual_aperture(i), before%residual_aperture(old), &
                                    0.0_rk, "residual aperture kept")
               call checks%is_close(after%roughness(i), before%roughness(old), 0.0_rk, &
                                    "roughness kept")
            else
               ! Cells are stored along their fracture: the new ones were added at its first or last
               ! cell.
               old = merge(first, last, mesh%fracture%cell_s(2, i) <= 1.0e-12_rk)
               call checks%is_true(here(i) == 1, "only fracture 1 has grown")
               call checks%is_close(after%residual_aperture(i), new_aperture, 0.0_rk, &
                                    "new aperture")
               call checks%is_close(after%roughness(i), new_aperture, 0.0_rk, "which is rough")
            end if
            call checks%is_close(after%law(i)%friction, before%law(old)%friction, 0.0_rk, &
                                 "friction")
            call checks%is_close(after%law(i)%dilation, before%law(old)%dilation, 0.0_rk, &
                                 "dilation")
         end do
      end associate
   end subroutine test_cells

   !> An irregular state on the old mesh.
   subroutine various_state(state)
      type(state_t), intent(out) :: state
      integer(ik) :: i

      associate (n => mesh_before%fracture%n_cells, n_blocks => mesh_before%n_cells &
                 + 2*mesh_before%fracture%n_cells)
         state%time = 1234.5_rk
         allocate (state%unknowns, source=reshape(scattered(3*n_blocks), [3_ik, n_blocks]))
         allocate (state%content, source=1.0e-5_rk*scattered(mesh_before%n_cells))
         allocate (state%jump, source=reshape(1.0e-4_rk*scattered(4*n), [2_ik, 2_ik, n]))
         allocate (state%slip_before, source=reshape(1.0e-4_rk*scattered(2*n), [2_ik, n]))
         allocate (state%traction, source=reshape(-1.0e7_rk*scattered(4*n + 1), [2_ik, 2_ik, n]))
         allocate (state%contact(2, n), source=state_slip)
         state%contact(1, :) = state_open
         allocate (state%pressure, source=[(1.0e6_rk + i, i=1, n)])
         allocate (state%aperture, source=1.0e-3_rk + 1.0e-4_rk*scattered(n))
         allocate (state%void, source=[(1.0e-5_rk*i, i=1, n)])
         allocate (state%leakoff, source=1.0e-9_rk*scattered(n))
         allocate (state%injection, source=[(1.0e-9_rk*i, i=1, n)])
      end associate
   end subroutine various_state

   subroutine test_state(is_prefilled)
      logical, intent(in) :: is_prefilled
      type(fracture_cells_t) :: cells, cells_before
      type(state_t) :: after, before
      real(rk) :: length, prefilled, volume
      integer(ik) :: c, i, old, origin

      call various_cells(cells_before)
      call transfer_cells(mesh_before, mesh, cells_before, new_aperture, is_prefilled, cells)
      call various_state(before)
      call transfer_state(map, mesh_before, mesh, cells, is_prefilled, before, after, prefilled)
      call checks%is_close(after%time, before%time, 0.0_rk, "time")
      call checks%is_close(sum(after%content), sum(before%content), &
                           1.0e-14_rk*sum(abs(before%content)), "the rock's fluid is conserved")
      do c = 1, mesh%n_cells
         old = map%cell_old(c)
         if (old == 0) cycle
         call checks%is_close(after%content(c), before%content(old), 0.0_rk, "content kept")
         call checks%is_close(maxval(abs(after%unknowns(:, c) - before%unknowns(:, old))), &
                              0.0_rk, 0.0_rk, "unknowns kept")
      end do
      volume = 0.0_rk
      do i = 1, mesh%fracture%n_cells
         old = map%fracture_cell_old(i)
         if (old > 0) then
            call checks%is_true(all(after%contact(:, i) == before%contact(:, old)) &
                                .and. equal([after%jump(:, :, i)], [before%jump(:, :, old)]) &
                                .and. equal([after%traction(:, :, i)], &
                                            [before%traction(:, :, old)]) &
                                .and. equal([after%pressure(i), after%aperture(i), &
                                             after%leakoff(i), after%void(i), after%injection(i)], &
                                            [before%pressure(old), before%aperture(old), &
                                             before%leakoff(old), before%void(old), &
                                             before%injection(old)]), &
                                "an old fracture cell is kept to the last bit")
            cycle
         end if
         length = mesh%fracture%cell_s(2, i) - mesh%fracture%cell_s(1, i)
         associate (there => mesh_before%fracture%cell_fracture)
            origin = merge(findloc(there, 1_ik, dim=1), &
                           findloc(there, 1_ik, dim=1, back=.true.), &
                           mesh%fracture%cell_s(2, i) <= 1.0e-12_rk)
         end associate
         call checks%is_close(after%pressure(i), before%pressure(origin), 0.0_rk, &
                              "a new cell has the pressure of the one it grew from")
         call checks%is_close(after%aperture(i), new_aperture, 0.0_rk, "a new cell's aperture")
         call checks%is_close(after%injection(i), 0.0_rk, 0.0_rk, "nothing is fed into it")
         call checks%is_true(all(after%contact(:, i) == state_stick) .and. &
                             equal([after%jump(:, :, i)], [0.0_rk, 0.0_rk, 0.0_rk, 0.0_rk]), &
                             "a new cell is closed")
         volume = volume + length*(after%aperture(i) - cells%roughness(i))
      end do
      call checks%is_close(prefilled, volume, 1.0e-15_rk*max(volume, 1.0e-6_rk), "prefilled volume")
      call checks%is_true((prefilled > 0.0_rk) .eqv. is_prefilled, "prefilled only if wanted")
   end subroutine test_state

   !> A fracture grows into another one, at a share of a cell: in the middle the cell is divided,
   !! near its start the node there moves. The fluid of the fracture is preserved, and jumps that
   !! are linear along it stay linear.
   subroutine test_joint(share)
      real(rk), intent(in) :: share
      real(rk), parameter :: lines(2, 2, 2) = reshape([0.5_rk, 1.0_rk, 0.95_rk, 1.0_rk, 1.0_rk, &
                                                       0.5_rk, 1.0_rk, 1.5_rk], [2, 2, 2])
      type(network_t) :: network
      type(error_t), allocatable :: error
      type(mesher_t) :: mesher_joined
      type(mesh_t) :: joined
      type(mesh_map_t) :: map_joined
      type(fracture_cells_t) :: cells, cells_before
      type(state_t) :: after, before
      real(rk) :: length, prefilled, s(2), volume(3, 2), worst
      integer(ik) :: c, i

      network = straight_network(lines)
      call mesh_square(checks, network, 0.1_rk, 0.3_rk, mesh_before, mesher_before)
      call extend(network, 1_ik, 2_ik, [1.0_rk, 1.0_rk + 0.1_rk*share])
      call remesh(mesher_before, network, reshape([1.0_rk, 1.0_rk], [2, 1]), 0.3_rk, 0.1_rk, &
                  mesher_joined, joined, map_joined, error)
      call checks%no_error(error, "mesh with a joint")
      cells_before = uniform_cells(mesh_before, contact_law_t(), 1.0e-3_rk)
      cells_before%roughness = spread(0.0_rk, 1, mesh_before%fracture%n_cells)
      call transfer_cells(mesh_before, joined, cells_before, new_aperture, .false., cells)
      call various_state(before)
      associate (fracture => mesh_before%fracture)
         do i = 1, fracture%n_cells
            s = matmul(reshape([2.0_rk, 1.0_rk, 1.0_rk, 2.0_rk], [2, 2]), fracture%cell_s(:, i)) &
                /3.0_rk
            before%jump(1, :, i) = 1.0e-4_rk*(1.0_rk + s)
            before%jump(2, :, i) = -2.0e-4_rk*s
            before%slip_before(:, i) = 3.0e-4_rk*s
            before%aperture(i) = 1.0e-3_rk + 0.5_rk*sum(before%jump(1, :, i))
         end do
      end associate
      call transfer_state(map_joined, mesh_before, joined, cells, .false., before, after, prefilled)
      volume = 0.0_rk
      associate (fracture => mesh_before%fracture)
         do i = 1, fracture%n_cells
            if (fracture%cell_fracture(i) /= 2) cycle
            length = fracture%cell_s(2, i) - fracture%cell_s(1, i)
            volume(:, 1) = volume(:, 1) + length*[before%aperture(i), before%void(i), &
                                           (before%aperture(i) - before%void(i))*before%pressure(i)]
         end do
      end associate
      worst = 0.0_rk
      c = 0
      do i = 1, joined%fracture%n_cells
         if (joined%fracture%cell_fracture(i) /= 2) cycle
         associate (ends => joined%fracture%cell_s(:, i))
            length = ends(2) - ends(1)
            s = matmul(reshape([2.0_rk, 1.0_rk, 1.0_rk, 2.0_rk], [2, 2]), ends)/3.0_rk
         end associate
         c = c + 1
         volume(:, 2) = volume(:, 2) + length*[after%aperture(i), after%void(i), &
                                              (after%aperture(i) - after%void(i))*after%pressure(i)]
         worst = max(worst, maxval(abs(after%jump(1, :, i) - 1.0e-4_rk*(1.0_rk + s))), &
                     maxval(abs(after%jump(2, :, i) + 2.0e-4_rk*s)), &
                     maxval(abs(after%slip_before(:, i) - 3.0e-4_rk*s)), &
                     abs(after%aperture(i) - 1.0e-3_rk - 0.5_rk*sum(after%jump(1, :, i))))
         call checks%is_close(cells%residual_aperture(i), 1.0e-3_rk, 1.0e-18_rk, "aperture at rest")
         call checks%is_close(cells%roughness(i), 0.0_rk, 0.0_rk, "the old faces")
      end do
      call checks%is_close(worst, 0.0_rk, 1.0e-18_rk, "linear jumps")
      do i = 1, 3
         call checks%is_close(volume(i, 2), volume(i, 1), 1.0e-14_rk*volume(i, 1), &
                              "the fracture's fluid is conserved")
      end do
      call checks%is_true(c > mesh_before%fracture%n_cells - count( &
                          mesh_before%fracture%cell_fracture == 1), "cells have been divided")
   end subroutine test_joint

   !> Whether two arrays are equal to the last bit.
   pure function equal(a, b)
      real(rk), intent(in) :: a(:), b(:)
      logical :: equal

      equal = .not. any(abs(a - b) > 0.0_rk)
   end function equal

   !> A uniform content per area stays uniform in the new cells, and so do uniform unknowns.
   subroutine test_uniform_content()
      type(fracture_cells_t) :: cells, cells_before
      type(state_t) :: after, before
      real(rk) :: prefilled
      integer(ik) :: c

      call various_cells(cells_before)
      call transfer_cells(mesh_before, mesh, cells_before, new_aperture, .false., cells)
      call various_state(before)
      before%content = [(3.0e-4_rk*cell_area(mesh_before, c), c=1, mesh_before%n_cells)]
      before%unknowns(3, :) = 5.0e6_rk
      call transfer_state(map, mesh_before, mesh, cells, .false., before, after, prefilled)
      call checks%is_close(maxval([(abs(after%content(c)/cell_area(mesh, c) - 3.0e-4_rk), &
                                    c=1, mesh%n_cells)]), 0.0_rk, 3.0e-15_rk, "uniform content")
      call checks%is_close(maxval(abs(after%unknowns(3, :mesh%n_cells) - 5.0e6_rk)), 0.0_rk, &
                           1.0e-4_rk, "uniform pressure")
   end subroutine test_uniform_content

   !> The guess keeps the changes of old cells, flows and wells in physical units (jumps and flows
   !! are scaled with the mean length of the cells); new cells do not change.
   subroutine test_guess()
      type(guess_t) :: guess
      type(fracture_layout_t) :: new, old
      integer(ik), allocatable :: pairs(:, :), pairs_before(:, :)
      real(rk) :: finer
      integer(ik) :: cell, k, of

      pairs_before = neighbours(mesh_before)
      pairs = neighbours(mesh)
      old = fracture_layout_t(n_cells=mesh_before%fracture%n_cells, per_cell=7_ik, &
                              n_flows=size(pairs_before, 2, kind=ik), n_wells=1_ik)
      new = fracture_layout_t(n_cells=mesh%fracture%n_cells, per_cell=7_ik, &
                              n_flows=size(pairs, 2, kind=ik), n_wells=1_ik)
      guess%change = [(real(k, rk), k=1, old%count())]
      associate (before => mesh_before%fracture, after => mesh%fracture)
         finer = sum(before%cell_s(2, :) - before%cell_s(1, :))/before%n_cells &
                 /(sum(after%cell_s(2, :) - after%cell_s(1, :))/after%n_cells)
         call transfer_guess(before, after, pairs_before, pairs, old, new, guess)
         call checks%is_true(guess%is_known(new%count()), "guess: as many as unknowns")
         do cell = 1, after%n_cells
            of = map%fracture_cell_old(cell)
            if (of == 0) then
               call checks%is_close(maxval(abs(guess%change(7*cell - 6:7*cell))), 0.0_rk, 0.0_rk, &
                                    "guess: none in new cells")
            else
               call checks%is_close(guess%change(new%at_jump(cell, 2_ik)), &
                                    finer*old%at_jump(of, 2_ik), 1.0e-10_rk, "guess: jump")
               call checks%is_close(guess%change(new%at_pressure(cell)), &
                                    real(old%at_pressure(of), rk), 1.0e-10_rk, "guess: pressure")
            end if
         end do
         do k = 1, size(pairs, 2, kind=ik)
            if (any(map%fracture_cell_old(pairs(:, k)) == 0)) cycle
            of = findloc(pairs_before(1, :), map%fracture_cell_old(pairs(1, k)), dim=1, kind=ik)
            call checks%is_close(guess%change(new%at_flow(k)), finer**2*old%at_flow(of), &
                                 1.0e-10_rk, "guess: flow")
         end do
      end associate
      call checks%is_close(guess%change(new%at_well(1_ik)), finer**2*old%at_well(1_ik), &
                           1.0e-10_rk, "guess: well")
      call transfer_guess(mesh_before%fracture, mesh%fracture, pairs_before, pairs, old, new, guess)
      call checks%is_true(.not. guess%is_known(new%count()), "guess: not of another mesh")
   end subroutine test_guess

   !> Pairs of cells that follow each other on a fracture.
   function neighbours(of) result(pairs)
      type(mesh_t), intent(in) :: of
      integer(ik), allocatable :: pairs(:, :)
      integer(ik) :: i, k

      allocate (pairs(2, 0))
      associate (f => of%fracture)
         do i = 1, f%n_cells
            do k = 1, f%n_cells
               if (f%cell_fracture(i) /= f%cell_fracture(k)) cycle
               if (abs(f%cell_s(2, i) - f%cell_s(1, k)) > 1.0e-9_rk) cycle
               pairs = reshape([pairs, i, k], [2, size(pairs, 2) + 1])
            end do
         end do
      end associate
   end function neighbours

end program test_twolevel_transfer
