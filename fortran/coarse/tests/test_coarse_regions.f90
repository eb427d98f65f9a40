!> Interaction regions: what meets around each vertex, at tips, joints, kinks and on the boundary;
!! corners of cells.
program test_coarse_regions
   use base_kinds, only: ik, rk
   use coarse_regions, only: find_regions, fracture_end_region, regions_t, traction_face
   use mesh_geometry, only: corner_geometry, face_length
   use mesh_types, only: mesh_t, network_t
   use sample_bodies, only: mesh_square, shake, straight_network
   use testing_checks, only: checks_t
   implicit none(type, external)

   type(checks_t) :: checks

   call test_single_fracture()
   call test_joints()
   call test_corner()
   call test_kink()
   call test_whole_body_cut()
   call test_corner_geometry()
   call test_traction_face()
   call checks%finish()

contains

   !> What holds in every mesh: each node, face end and block end appears once, in the region where
   !! it lies.
   subroutine check_regions(mesh, regions, name)
      type(mesh_t), intent(in) :: mesh
      type(regions_t), intent(in) :: regions
      character(len=*), intent(in) :: name

      integer(ik), allocatable :: found(:)
      integer(ik) :: i, n_wrong, r
      real(rk) :: place(2)

      associate (n => regions%n_regions, m => mesh%fracture%n_cells)
         call checks%is_true(all(tally(regions%nodes%item, mesh%n_nodes) == 1), &
                             name//": nodes once")
         call checks%is_true(all(tally(regions%flow_faces%item, mesh%n_faces) == 2), &
                             name//": faces for the flow at both ends")
         allocate (found, source=tally(regions%faces%item, mesh%n_faces))
         do i = 1, m
            call checks%is_true(found(mesh%fracture%cell_faces(2, i)) == 0, &
                                name//": side + carries the traction")
            found(mesh%fracture%cell_faces(2, i)) = 2
         end do
         call checks%is_true(all(found == 2), name//": faces for tractions at both ends")
         found = tally(regions%blocks%item, regions%n_blocks)
         call checks%is_true(regions%n_blocks == mesh%n_cells + 2*m, name//": number of blocks")
         call checks%is_true(all(found(:mesh%n_cells) == 3), name//": cells in three regions")
         call checks%is_true(all(found(mesh%n_cells + 1:) == 2), name//": fractures in two")
         n_wrong = 0
         do r = 1, n
            place = mesh%xy(:, regions%nodes%at(r, 1_ik))
            do i = 1, regions%nodes%length(r)
               if (.not. norm2(mesh%xy(:, regions%nodes%at(r, i)) - place) <= 1.0e-12_rk) then
                  n_wrong = n_wrong + 1
               end if
            end do
            do i = 1, regions%flow_faces%length(r)
               associate (ends => mesh%xy(:, mesh%face_nodes(:, regions%flow_faces%at(r, i))))
                  if (.not. minval(norm2(ends - spread(place, 2, 2), dim=1)) <= 1.0e-12_rk) then
                     n_wrong = n_wrong + 1
                  end if
               end associate
            end do
            do i = 1, regions%blocks%length(r)
               if ((regions%blocks%at(r, i) <= mesh%n_cells) .neqv. &
                   (i <= regions%cell_count(r))) n_wrong = n_wrong + 1
            end do
         end do
         call checks%is_true(n_wrong == 0, name//": everything lies in its region, cells first")
         call checks%is_true(regions%traction_count() &
                             == 2*size(regions%faces%item) + size(regions%nodes%item), &
                             name//": packed tractions")
         n_wrong = 0
         do i = 1, m
            do r = 1, 2
               associate (region => fracture_end_region(mesh, regions, i, r), &
                          point => mesh%fracture%point_xy(:, mesh%fracture%cell_points(r, i)))
                  if (.not. norm2(mesh%xy(:, regions%nodes%at(region, 1_ik)) &
                                  - point) <= 1.0e-12_rk) n_wrong = n_wrong + 1
               end associate
            end do
         end do
         call checks%is_true(n_wrong == 0, name//": ends of fracture cells")
      end associate
   end subroutine check_regions

   !> How often each number from 1 to n appears.
   pure function tally(items, n) result(times)
      integer(ik), intent(in) :: items(:)
      integer(ik), intent(in) :: n
      integer(ik), allocatable :: times(:)
      integer(ik) :: i

      allocate (times(n), source=0_ik)
      do i = 1, size(items)
         times(items(i)) = times(items(i)) + 1
      end do
   end function tally

   subroutine mesh_and_regions(network, mesh, regions, name)
      type(network_t), intent(in) :: network
      type(mesh_t), intent(out) :: mesh
      type(regions_t), intent(out) :: regions
      character(len=*), intent(in) :: name

      call mesh_square(checks, network, 0.2_rk, 0.5_rk, mesh)
      call find_regions(mesh, regions)
      call check_regions(mesh, regions, name)
   end subroutine mesh_and_regions

   !> The region at a place: nodes, and blocks of fracture cells.
   subroutine check_place(mesh, regions, place, n_nodes, n_fracture_cells, name)
      type(mesh_t), intent(in) :: mesh
      type(regions_t), intent(in) :: regions
      real(rk), intent(in) :: place(2)
      integer(ik), intent(in) :: n_nodes, n_fracture_cells
      character(len=*), intent(in) :: name
      integer(ik) :: r

      r = regions%region_of_node(minloc(norm2(mesh%xy - spread(place, 2, size(mesh%xy, 2)), &
                                              dim=1), dim=1))
      call checks%is_true(regions%nodes%length(r) == n_nodes, &
                          name//": nodes joined")
      call checks%is_true(regions%blocks%length(r) - regions%cell_count(r) &
                          == 2*n_fracture_cells, name//": fracture cells")
   end subroutine check_place

   !> A free tip is one node; inside the fracture two nodes are joined; a tip-less end splits the
   !! boundary.
   subroutine test_single_fracture()
      type(mesh_t) :: mesh
      type(regions_t) :: regions

      call mesh_and_regions(straight_network(reshape([0.0_rk, 1.0_rk, 1.0_rk, 1.0_rk], &
                                                     [2, 2, 1])), mesh, regions, "single")
      call check_place(mesh, regions, [0.0_rk, 1.0_rk], 2_ik, 1_ik, "end on the boundary")
      call check_place(mesh, regions, [0.2_rk, 1.0_rk], 2_ik, 2_ik, "inside the fracture")
      call check_place(mesh, regions, [1.0_rk, 1.0_rk], 1_ik, 1_ik, "tip")
      call check_place(mesh, regions, [2.0_rk, 2.0_rk], 1_ik, 0_ik, "corner of the body")
   end subroutine test_single_fracture

   !> Crossing (X) and abutting (T) fractures.
   subroutine test_joints()
      type(mesh_t) :: mesh
      type(regions_t) :: regions
      real(rk), parameter :: ends(2, 2, 3) = reshape([0.4_rk, 1.0_rk, 1.6_rk, 1.0_rk, 0.8_rk, &
                                                      0.6_rk, 0.8_rk, 1.4_rk, 1.2_rk, 1.0_rk, &
                                                      1.2_rk, 1.6_rk], [2, 2, 3])

      call mesh_and_regions(straight_network(ends), mesh, regions, "joints")
      call check_place(mesh, regions, [0.8_rk, 1.0_rk], 4_ik, 4_ik, "crossing")
      call check_place(mesh, regions, [1.2_rk, 1.0_rk], 3_ik, 3_ik, "T joint")
      call check_place(mesh, regions, [1.2_rk, 1.6_rk], 1_ik, 1_ik, "tip of the branch")
   end subroutine test_joints

   !> Two fractures that meet at their ends (V).
   subroutine test_corner()
      type(mesh_t) :: mesh
      type(regions_t) :: regions
      real(rk), parameter :: ends(2, 2, 2) = reshape([0.4_rk, 0.6_rk, 1.0_rk, 1.0_rk, 1.0_rk, &
                                                      1.0_rk, 1.6_rk, 0.6_rk], [2, 2, 2])

      call mesh_and_regions(straight_network(ends), mesh, regions, "corner")
      call check_place(mesh, regions, [1.0_rk, 1.0_rk], 2_ik, 2_ik, "V joint")
   end subroutine test_corner

   subroutine test_kink()
      type(mesh_t) :: mesh
      type(regions_t) :: regions
      type(network_t) :: network

      allocate (network%first, source=[1_ik, 4_ik])
      allocate (network%s_start, source=[0.0_rk])
      network%xy = reshape([0.4_rk, 0.6_rk, 1.0_rk, 1.0_rk, 1.0_rk, 1.6_rk], [2, 3])
      call mesh_and_regions(network, mesh, regions, "kink")
      call check_place(mesh, regions, [1.0_rk, 1.0_rk], 2_ik, 2_ik, "kink")
   end subroutine test_kink

   !> Both ends on the boundary: the body falls into two, which the regions join.
   subroutine test_whole_body_cut()
      type(mesh_t) :: mesh
      type(regions_t) :: regions

      call mesh_and_regions(straight_network(reshape([0.0_rk, 0.6_rk, 2.0_rk, 1.4_rk], &
                                                     [2, 2, 1])), mesh, regions, "cut")
      call check_place(mesh, regions, [0.0_rk, 0.6_rk], 2_ik, 1_ik, "left end")
      call check_place(mesh, regions, [2.0_rk, 1.4_rk], 2_ik, 1_ik, "right end")
      call checks%is_true(mesh%n_nodes - regions%n_regions == mesh%fracture%n_cells + 1, &
                          "every point of the cut joins two nodes")
   end subroutine test_whole_body_cut

   !> sigma = sum of sign t (x) lever gives back any constant tensor; lengths and area are right.
   subroutine test_corner_geometry()
      type(mesh_t) :: mesh
      real(rk), parameter :: stress(2, 2) = reshape([3.0_rk, -1.0_rk, 2.0_rk, 5.0_rk], [2, 2])
      real(rk) :: rebuilt(2, 2), traction(2), sign_out(2), length(2), lever(2, 2), area, total
      integer(ik) :: c, faces(2), j, k, n_wrong
      real(rk) :: worst

      call mesh_square(checks, straight_network(reshape([0.5_rk, 0.7_rk, 1.4_rk, 1.2_rk], &
                                                        [2, 2, 1])), 0.2_rk, 0.5_rk, mesh)
      call shake(mesh)
      worst = 0.0_rk
      total = 0.0_rk
      n_wrong = 0
      do c = 1, mesh%n_cells
         do k = 1, 3
            call corner_geometry(mesh, c, k, faces, sign_out, length, lever, area)
            if (.not. area > 0.0_rk) n_wrong = n_wrong + 1
            rebuilt = 0.0_rk
            do j = 1, 2
               if (.not. any(mesh%face_nodes(:, faces(j)) == mesh%cell_nodes(k, c))) then
                  n_wrong = n_wrong + 1
               end if
               if (.not. abs(length(j) - face_length(mesh, faces(j))) <= 1.0e-15_rk) then
                  n_wrong = n_wrong + 1
               end if
               traction = matmul(stress, outward_normal(mesh, c, faces(j)))
               ! The face's own normal leaves its first cell.
               if (mesh%face_cells(1, faces(j)) /= c) traction = -traction
               rebuilt = rebuilt + sign_out(j)*spread(traction, 2, 2)*spread(lever(:, j), 1, 2)
            end do
            worst = max(worst, maxval(abs(rebuilt - stress)))
         end do
         total = total + area
      end do
      call checks%is_true(n_wrong == 0, "faces at the corner, lengths, orientation")
      call checks%is_close(worst, 0.0_rk, 1.0e-13_rk, "a constant tensor from its tractions")
      call checks%is_close(total, 4.0_rk, 1.0e-13_rk, "areas add up to the body's")
   end subroutine test_corner_geometry

   !> Unit normal of a cell's face, found from the opposite node.
   pure function outward_normal(mesh, cell, face) result(normal)
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: cell, face
      real(rk) :: normal(2)

      associate (a => mesh%xy(:, mesh%face_nodes(1, face)), b => mesh%xy(:, &
                                                                         mesh%face_nodes(2, face)))
         normal = [b(2) - a(2), a(1) - b(1)]/norm2(b - a)
         if (dot_product(normal, a - sum(mesh%xy(:, mesh%cell_nodes(:, cell)), &
                                         dim=2)/3.0_rk) < 0.0_rk) normal = -normal
      end associate
   end function outward_normal

   !> Both sides of a fracture share the traction of side +; other faces stay as they are.
   subroutine test_traction_face()
      type(mesh_t) :: mesh
      integer(ik) :: face, i
      real(rk) :: sign_out

      call mesh_square(checks, straight_network(reshape([0.5_rk, 0.7_rk, 1.4_rk, 1.2_rk], &
                                                        [2, 2, 1])), 0.3_rk, 0.5_rk, mesh)
      do i = 1, mesh%fracture%n_cells
         face = mesh%fracture%cell_faces(2, i)
         sign_out = 1.0_rk
         call traction_face(mesh, face, sign_out)
         call checks%is_true(face == mesh%fracture%cell_faces(1, i), "from side - to side +")
         call checks%is_close(sign_out, -1.0_rk, 0.0_rk, "sign turned")
         call traction_face(mesh, face, sign_out)
         call checks%is_true(face == mesh%fracture%cell_faces(1, i), "side + stays")
         call checks%is_close(sign_out, -1.0_rk, 0.0_rk, "sign stays")
      end do
      do i = 1, mesh%n_faces
         if (mesh%face_fracture_cell(i) > 0) cycle
         face = i
         call traction_face(mesh, face, sign_out)
         call checks%is_true(face == i, "other faces stay")
      end do
   end subroutine test_traction_face

end program test_coarse_regions
